#pragma once
// Rows in parallel. Private to the library.

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace dem::numeric {

/// Runs `work()` with at most `threads` threads for the loops inside it (0: all cores). More
/// threads than cores are not started.
template <class Work>
auto with_threads(int threads, Work work) {
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, cores) : cores);
  return arena.execute(work);
}

/// Calls `each(i)` for begin <= i < end, in parallel, at least `grain` consecutive i to a thread.
/// The calls must not depend on each other: then no number of threads changes the result.
template <class Each>
void parallel_for(int begin, int end, int grain, Each each) {
  tbb::parallel_for(tbb::blocked_range<int>(begin, end, std::size_t(grain)),
                    [&](const tbb::blocked_range<int>& range) {
                      for (int i = range.begin(); i < range.end(); ++i) each(i);
                    });
}

}  // namespace dem::numeric
