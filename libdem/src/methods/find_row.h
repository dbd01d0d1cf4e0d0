#pragma once
// How a row of a table of methods is found by its name. Private to the library.

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "dem/methods.h"

namespace dem::methods {

/// The row called `name`, "NAME" or "NAME:PRESET", and the settings of its preset.
template <class Row>
std::pair<const Row*, Settings> find_row(const std::vector<Row>& table, std::string_view kind,
                                         std::string_view name) {
  const auto colon = name.find(':');
  const auto row = std::ranges::find(table, name.substr(0, colon), &Row::name);
  std::vector<std::string> names;
  if (row == table.end()) {
    for (const auto& r : table) names.push_back(r.name);
    throw std::invalid_argument(
        fmt::format("unknown {} \"{}\"; must be one of {}", kind, name, fmt::join(names, ", ")));
  }
  if (colon == std::string_view::npos) return {&*row, {}};
  const auto preset = std::ranges::find(row->presets, name.substr(colon + 1), &Preset::name);
  if (preset == row->presets.end()) {
    for (const auto& p : row->presets) names.push_back(row->name + ":" + p.name);
    throw std::invalid_argument(
        fmt::format("unknown preset \"{}\"; {} has {}", name, row->name,
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  return {&*row, preset->settings};
}

}  // namespace dem::methods
