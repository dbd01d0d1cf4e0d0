// The tables of methods and generators, as plain values.

#include <pybind11/stl.h>

#include "bind.h"
#include "dem/draw.h"
#include "dem/erosion.h"
#include "dem/generators.h"
#include "dem/gridding.h"
#include "dem/io/methods.h"
#include "dem/io/point_files.h"
#include "dem/io/rasters.h"
#include "dem/raytrace.h"
#include "dem/supersample.h"

namespace dem::python {

namespace py = pybind11;

namespace {

py::list as_list(const std::vector<FieldInfo>& fields) {
  py::list all;
  for (const FieldInfo& f : fields) {
    py::dict row;
    row["name"] = f.name;
    row["type"] = f.type;
    row["unit"] = f.unit;
    row["range"] = f.range;
    row["default"] = f.default_text;
    row["choices"] = f.choices;
    row["doc"] = f.doc;
    all.append(row);
  }
  return all;
}

py::list as_list(const std::vector<Preset>& presets) {
  py::list all;
  for (const Preset& p : presets) {
    py::dict row;
    row["name"] = p.name;
    row["doc"] = p.doc;
    row["settings"] = p.settings;
    all.append(row);
  }
  return all;
}

template <class Row>
py::dict as_dict(const Row& row) {
  py::dict out;
  out["name"] = row.name;
  out["summary"] = row.summary;
  out["citation"] = row.citation;
  out["fields"] = as_list(row.fields);
  out["presets"] = as_list(row.presets);
  return out;
}

template <class Options>
py::list fields_of() {
  Options options;
  return as_list(describe(fields(options)));
}

}  // namespace

void bind_tables(py::module_& module) {
  module.attr("default_method") = std::string(default_fill_method());
  module.def("methods", [] {
    py::list all;
    for (const FillMethod& m : all_fill_methods()) {
      py::dict row = as_dict(m);
      row["bytes_per_cell"] = m.traits.bytes_per_cell.value;
      all.append(row);
    }
    return all;
  });
  module.def("generators", [] {
    py::list all;
    for (const Generator& g : generators()) {
      py::dict row = as_dict(g);
      row["image"] = g.image;
      row["globe"] = g.globe;
      all.append(row);
    }
    return all;
  });
  module.def("option_fields", [] {
    py::dict options;
    options["bin"] = fields_of<BinOptions>();
    options["points"] = fields_of<PointReadOptions>();
    options["gridding"] = fields_of<GriddingOptions>();
    options["supersample"] = fields_of<SupersampleOptions>();
    options["write"] = fields_of<WriteOptions>();
    return options;
  });
  module.def("erosion_fields", &fields_of<ErosionOptions>);
  module.def("style_fields", [] {
    py::dict styles;
    styles["relief"] = fields_of<ReliefOptions>();
    styles["hillshade"] = fields_of<HillshadeOptions>();
    styles["view"] = fields_of<ViewOptions>();
    return styles;
  });
}

}  // namespace dem::python
