#pragma once
// Sampling by what a reconstruction needs: the cells that it misses worst.

#include <cstddef>
#include <vector>

#include "dem/methods.h"

namespace dem {

/// One of the two says when to stop.
struct GreedyOptions {
  std::size_t count = 0;   ///< keep exactly so many cells; 0: as many as max_error_m needs
  double max_error_m = 0;  ///< stop when no known cell is missed by more; 0: count alone
};
std::vector<Field> fields(GreedyOptions& options);

/// How far the reconstruction from so many cells is off, over all known cells.
struct GreedyRound {
  std::size_t kept = 0;
  double rmse_m = 0, max_error_m = 0;
};

struct GreedySample {
  Dem dem;                          ///< with the kept cells only
  std::vector<GreedyRound> rounds;  ///< the last one is that of `dem`, made by reconstructing it
};

/// Keeps the cells from which the method reconstructs the DEM best: round by round, the worst cells
/// of blocks of half the mean distance are added, and the rest is reconstructed.
/// Gives:  with max_error_m (and no smaller count), a DEM whose reconstruction misses no known cell
///         by more: the last round was reconstructed from it.
/// Cost:   a fill a round; about 1.4 times as many cells in each.
/// Throws: std::invalid_argument: not exactly one of the two options, count not in [4, known
///         cells]; Cancelled.
GreedySample sample_greedy(const Dem& dem, const ChosenMethod& method, const GreedyOptions& options,
                           const Run& run = {});

}  // namespace dem
