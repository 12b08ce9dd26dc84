/// @file
/// The same work on several threads.
#pragma once

#include <functional>
#include <utility>

namespace flexarm::solids {

/// `asked`, or as many threads as the machine has cores if that is 0.
/// @throws InvalidParameter if it is negative.
int thread_count(int asked);

/// Calls work(t) for t = 0 .. n_threads − 1, each on its own thread. Of several exceptions that of the lowest
/// t is thrown on, so that a message does not depend on which thread was faster.
void in_parallel(int n_threads, const std::function<void(int)>& work);

/// Part t of n_threads nearly equal parts of [begin, end).
template <class Index>
std::pair<Index, Index> part_of(Index begin, Index end, int t, int n_threads) {
  const Index n = end - begin;
  return {begin + n * t / n_threads, begin + n * (t + 1) / n_threads};
}

}  // namespace flexarm::solids
