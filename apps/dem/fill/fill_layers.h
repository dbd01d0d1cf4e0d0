#pragma once
// What a fill knows beside the raster: auxiliary DEMs and polygons of water.

#include <memory>
#include <string>
#include <vector>

#include "common.h"
#include "dem/holes.h"
#include "dem/io/polygons.h"
#include "dem/io/raster_stream.h"

namespace dem::app {

class FillLayers {
 public:
  /// Throws IoError when a file cannot be read or does not fit the raster.
  FillLayers(const std::vector<std::string>& aux, const std::string& water, const GeoRef& ref);

  /// Puts the box's part of them into `data`. Not to be called from two threads.
  void add(WindowData& data, const Box& box);

  /// How much of the raster an auxiliary DEM covered, and where it seems to lie beside it.
  struct Fit {
    std::string path;
    std::size_t cells = 0;                  ///< known in both, in the windows
    double offset_m = 0;                    ///< median of (raster - aux)
    double shift_cols = 0, shift_rows = 0;  ///< of the aux, by least squares on the slopes
    std::string warning;                    ///< "" when all seems well
  };
  std::vector<Fit> fits() const;

 private:
  struct Sums;
  std::vector<std::string> paths_;
  std::vector<AlignedReader> aux_;
  std::vector<Sums> sums_;
  std::unique_ptr<Polygons> water_;

 public:
  ~FillLayers();
};

}  // namespace dem::app
