#pragma once
// An evaluation as JSON: for --json and Python.

#include "common.h"
#include "dem/evaluation.h"

namespace dem::app {

/// Errors, calibration and spectra.
Json as_json(const Evaluation& evaluation);

}  // namespace dem::app
