#include "dem/io/fill_files.h"

#include <memory>

#include "dem/io/polygons.h"
#include "dem/io/raster_stream.h"

namespace dem {
namespace {

std::function<Mask(const Box&)> cells_in(const std::string& path, const GeoRef& ref) {
  if (path.empty()) return {};
  return [polygons = std::make_shared<Polygons>(path, ref)](const Box& box) {
    return polygons->cells_in(box);
  };
}

}  // namespace

FillLayers open_layers(const FillFiles& files, const GeoRef& ref) {
  FillLayers layers;
  for (const std::string& path : files.aux)
    layers.guides.push_back({path, [reader = std::make_shared<AlignedReader>(path, ref)](
                                       const Box& box) { return reader->read(box); }});
  layers.water = cells_in(files.water, ref);
  layers.region = cells_in(files.region, ref);
  return layers;
}

}  // namespace dem
