#pragma once
// What dem::io asks of OpenImageIO. That library brings some 150 others, so all that includes it
// lies in a module of its own, libdem-images.so, which is loaded when an image is read or drawn.
// Plain data crosses the boundary; the module uses no symbol of the library. Private to dem::io.

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dem::io {

enum class SampleType { uint8, uint16, float32 };

struct ImageShape {
  int cols = 0, rows = 0, channels = 1;
  int alpha_channel = -1;  ///< -1: none
  SampleType type = SampleType::uint8;
  std::string description = {};  ///< the image's own text
  int quality = 0;               ///< of lossy formats, 1 to 100; 0: OpenImageIO's choice
};

/// Called with the part done; returning true stops the work.
struct ImageProgress {
  bool (*call)(void* self, float part) = nullptr;
  void* self = nullptr;
};

/// An image that is open for reading.
class OpenImage {
 public:
  virtual ~OpenImage() = default;
  /// Its type is float32 for every type that is not one of the other two.
  virtual ImageShape shape() const = 0;
  /// All channels of all pixels: integers scaled to 0 ... 1, floats as they are.
  virtual void read(float* pixels, const ImageProgress& progress) = 0;
};

/// Each function throws std::runtime_error with OpenImageIO's message on one line.
class ImageModule {
 public:
  virtual std::unique_ptr<OpenImage> open(const std::string& path) const = 0;
  /// The bytes of a file with this name; none when its format can only be written to a file.
  virtual std::optional<std::vector<unsigned char>> encode(const std::string& name,
                                                           const ImageShape& shape,
                                                           const void* pixels,
                                                           const ImageProgress& progress) const = 0;
  /// Writes the file and reads it back, as not every writer notices that the disk is full.
  virtual void write(const std::string& path, const ImageShape& shape, const void* pixels,
                     const ImageProgress& progress) const = 0;
  virtual void median_filter(const float* from, float* to, int cols, int rows, int side,
                             int threads) const = 0;
  /// Heights and alpha (0 in a hole, as is the height) by turns; gives the heights alone.
  virtual void fill_holes_pushpull(const float* pixels, float* heights, int cols, int rows,
                                   int threads) const = 0;

 protected:
  ~ImageModule() = default;
};

/// The module, loaded by the first call.
/// Throws IoError, which says where the module was sought and which package holds it.
const ImageModule& image_module();

}  // namespace dem::io
