#pragma once
// Sampling by need: it keeps the cells at which a reconstruction has the largest errors.

#include <cstddef>
#include <vector>

#include "dem/methods.h"

namespace dem {

/// One of the two fields says when to stop.
struct GreedyOptions {
  std::size_t count = 0;   ///< number of cells to keep; 0: as many as max_error_m needs
  double max_error_m = 0;  ///< stop when no error is larger; 0: count decides alone
};
std::vector<Field> fields(GreedyOptions& options);

/// The errors of the reconstruction from `kept` cells, over all known cells.
struct GreedyRound {
  std::size_t kept = 0;
  double rmse_m = 0, max_error_m = 0;
};

struct GreedySample {
  Dem dem;                          ///< it has the kept cells only
  std::vector<GreedyRound> rounds;  ///< the last one is the reconstruction from `dem`
};

/// Keeps the cells from which the method reconstructs the DEM best.
/// In each round the worst cells of blocks of half the mean distance are added, and the rest is
/// reconstructed.
/// Gives:  with max_error_m (and no smaller count), a DEM whose reconstruction has no larger error
///         at any known cell. The last round was reconstructed from it.
/// Cost:   one fill for each round. Each round has about 1.4 times as many cells as the one before.
/// Throws: std::invalid_argument: not exactly one of the two options, or count not in [4, known
///         cells]; Cancelled.
GreedySample sample_greedy(const Dem& dem, const ChosenMethod& method, const GreedyOptions& options,
                           const Run& run = {});

}  // namespace dem
