#include "dem/methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "dem/mcmd.h"

namespace dem {

std::vector<FieldInfo> describe(const std::vector<Field>& fields) {
  std::vector<FieldInfo> infos;
  for (const auto& f : fields)
    infos.push_back({f.name(), f.type(), f.unit(), f.range(), f.text(), f.doc(), f.choices()});
  return infos;
}

ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name) {
  const auto colon = name.find(':');
  const auto method = std::ranges::find(table, name.substr(0, colon), &FillMethod::name);
  std::vector<std::string> names;
  if (method == table.end()) {
    for (const auto& m : table) names.push_back(m.name);
    throw std::invalid_argument(
        fmt::format("unknown method \"{}\"; must be one of {}", name, fmt::join(names, ", ")));
  }
  if (colon == std::string_view::npos) return {&*method, {}};
  const auto preset = std::ranges::find(method->presets, name.substr(colon + 1), &Preset::name);
  if (preset == method->presets.end()) {
    for (const auto& p : method->presets) names.push_back(method->name + ":" + p.name);
    throw std::invalid_argument(fmt::format("unknown preset \"{}\"; {} has {}", name, method->name,
                                            names.empty() ? "none"
                                                          : fmt::format("{}", fmt::join(names, ", "))));
  }
  return {&*method, preset->settings};
}

}  // namespace dem
