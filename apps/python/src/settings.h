#pragma once
// Methods with their settings, as Python gives them.

#include <string>

#include "dem/generators.h"
#include "dem/io/methods.h"

namespace dem::python {

/// A fill method by its name, with settings after its preset's. Bad ones throw
/// std::invalid_argument here, before long work.
inline ChosenMethod choose_method(const std::string& name, const Settings& settings) {
  ChosenMethod chosen = find_method(all_fill_methods(), name);
  chosen.settings.insert(chosen.settings.end(), settings.begin(), settings.end());
  chosen.check();
  return chosen;
}

}  // namespace dem::python
