// The module libdem-images.so: the only source that includes OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <stdexcept>

#include "io/images/image_module.h"

namespace dem::io {
namespace {

using OIIO::TypeDesc;

[[noreturn]] void fail(std::string message) {
  std::ranges::replace(message, '\n', ' ');
  throw std::runtime_error(message);
}

TypeDesc type_desc(SampleType type) {
  return type == SampleType::uint8    ? TypeDesc::UINT8
         : type == SampleType::uint16 ? TypeDesc::UINT16
                                      : TypeDesc::FLOAT;
}

SampleType sample_type(TypeDesc type) {
  return type == TypeDesc::UINT8    ? SampleType::uint8
         : type == TypeDesc::UINT16 ? SampleType::uint16
                                    : SampleType::float32;
}

OIIO::ImageSpec spec_of(const ImageShape& shape) {
  OIIO::ImageSpec spec(shape.cols, shape.rows, shape.channels, type_desc(shape.type));
  if (shape.channels < 3) {
    spec.channelnames = {"Y", "A"};
    spec.channelnames.resize(std::size_t(shape.channels));
  }
  spec.alpha_channel = shape.alpha_channel;
  if (shape.alpha_channel >= 0) spec["oiio:UnassociatedAlpha"] = 1;
  if (!shape.description.empty()) spec["ImageDescription"] = shape.description;
  if (shape.quality) spec.attribute("CompressionQuality", shape.quality);
  return spec;
}

class OiioImage final : public OpenImage {
 public:
  explicit OiioImage(const std::string& path) {
    OIIO::ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1;  // grey levels as stored, not multiplied by alpha
    input_ = OIIO::ImageInput::open(path, &config);
    if (!input_) fail(OIIO::geterror());
  }

  ImageShape shape() const override {
    const OIIO::ImageSpec& spec = input_->spec();
    return {.cols = spec.width,
            .rows = spec.height,
            .channels = spec.nchannels,
            .alpha_channel = spec.alpha_channel,
            .type = sample_type(spec.format),
            .description = std::string(spec.get_string_attribute("ImageDescription"))};
  }

  void read(float* pixels, const ImageProgress& progress) override {
    if (!input_->read_image(0, 0, 0, input_->spec().nchannels, TypeDesc::FLOAT, pixels,
                            OIIO::AutoStride, OIIO::AutoStride, OIIO::AutoStride, progress.call,
                            progress.self))
      fail(input_->geterror());
  }

 private:
  std::unique_ptr<OIIO::ImageInput> input_;
};

std::unique_ptr<OIIO::ImageOutput> create(const std::string& path, const ImageShape& shape) {
  auto output = OIIO::ImageOutput::create(path);
  if (!output) fail(OIIO::geterror());
  if (shape.alpha_channel >= 0 && !output->supports("alpha"))
    fail("this format has no alpha for unknown cells; unknown_grey must be given");
  return output;
}

void write_pixels(OIIO::ImageOutput& output, const std::string& path, const ImageShape& shape,
                  const void* pixels, const ImageProgress& progress) {
  const OIIO::ImageSpec spec = spec_of(shape);
  const bool written = output.open(path, spec) &&
                       output.write_image(spec.format, pixels, OIIO::AutoStride, OIIO::AutoStride,
                                          OIIO::AutoStride, progress.call, progress.self);
  const bool closed = output.close();
  if (!written || !closed) fail(output.geterror());
}

/// Whether an image can be read to its end.
bool is_whole(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return false;
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<char> bytes(spec.image_bytes(true));
  return input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeUnknown, bytes.data());
}

class OiioModule final : public ImageModule {
 public:
  std::unique_ptr<OpenImage> open(const std::string& path) const override {
    return std::make_unique<OiioImage>(path);
  }

  std::optional<std::vector<unsigned char>> encode(const std::string& name, const ImageShape& shape,
                                                   const void* pixels,
                                                   const ImageProgress& progress) const override {
    const auto output = create(name, shape);
    OIIO::Filesystem::IOVecOutput memory;
    if (!output->supports("ioproxy") || !output->set_ioproxy(&memory)) return std::nullopt;
    write_pixels(*output, name, shape, pixels, progress);
    return std::move(memory.buffer());
  }

  void write(const std::string& path, const ImageShape& shape, const void* pixels,
             const ImageProgress& progress) const override {
    write_pixels(*create(path, shape), path, shape, pixels, progress);
    if (!is_whole(path)) fail("cannot be written to the end; is the disk full?");
  }

  void median_filter(const float* from, float* to, int cols, int rows, int side,
                     int threads) const override {
    const OIIO::ImageSpec spec(cols, rows, 1, TypeDesc::FLOAT);
    const OIIO::ImageBuf source(spec, const_cast<float*>(from));  // which OpenImageIO only reads
    OIIO::ImageBuf target(spec, to);
    if (!OIIO::ImageBufAlgo::median_filter(target, source, side, side, {}, threads))
      fail("median filter: " + target.geterror());
  }

  void fill_holes_pushpull(const float* pixels, float* heights, int cols, int rows,
                           int threads) const override {
    OIIO::ImageSpec spec(cols, rows, 2, TypeDesc::FLOAT);
    spec.channelnames = {"Z", "A"};
    spec.alpha_channel = 1;
    const OIIO::ImageBuf holes(spec, const_cast<float*>(pixels));
    OIIO::ImageBuf filled;
    if (!OIIO::ImageBufAlgo::fillholes_pushpull(filled, holes, {}, threads) ||
        !filled.get_pixels(OIIO::ROI(0, cols, 0, rows, 0, 1, 0, 1), TypeDesc::FLOAT, heights))
      fail("fillholes_pushpull: " + filled.geterror());
  }
};

}  // namespace
}  // namespace dem::io

/// What image_module() asks for. The name changes with the interface.
extern "C" __attribute__((visibility("default"))) const dem::io::ImageModule*
DEM_IMAGE_MODULE_SYMBOL() {
  static const dem::io::OiioModule module;
  return &module;
}
