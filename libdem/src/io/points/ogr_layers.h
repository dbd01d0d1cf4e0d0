#pragma once
// A layer of a vector file. Private to dem::io.

#include <ogr_api.h>

#include <functional>
#include <string>

#include "io/gdal_support.h"

namespace dem::io {

class VectorLayer {
 public:
  /// Opens a layer; name "": the only one. Throws IoError.
  VectorLayer(const std::string& path, const std::string& name);

  OGRLayerH get() const { return layer_; }
  std::string driver() const;
  std::string crs_wkt() const;  ///< "": the layer says none

  /// The index of a number field. Throws IoError that lists the fields there are.
  int number_field(const std::string& option, const std::string& name) const;

  /// The field with the elevations: the one named, else that of a usual name; -1: the geometry's z.
  /// Throws IoError when there is neither.
  int elevation_field(const std::string& name) const;

  std::string field_name(int field) const;

  /// Calls each(feature) until it gives false. Throws IoError.
  void for_each(const std::function<bool(OGRFeatureH)>& each) const;

 private:
  std::string path_;
  DatasetPtr dataset_;
  OGRLayerH layer_ = nullptr;
};

/// Whether a column of this name usually holds elevations.
bool is_elevation_name(const std::string& name);

}  // namespace dem::io
