#include "flexarm/solids/parallel.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "flexarm/errors.hpp"

namespace flexarm::solids {
namespace {

// Beyond the cores of any machine.
constexpr int most_threads = 4096;

}  // namespace

int thread_count(int asked) {
  if (asked < 0 || asked > most_threads) {
    throw InvalidParameter("threads must be 0 (one a core) or up to " + std::to_string(most_threads) +
                           ", got " + std::to_string(asked));
  }
  if (asked > 0) return asked;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void in_parallel(int n_threads, const std::function<void(int)>& work) {
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(n_threads));
  const auto guarded = [&](int t) {
    try {
      work(t);
    } catch (...) {
      errors[static_cast<std::size_t>(t)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int t = 1; t < n_threads; ++t) threads.emplace_back(guarded, t);
    guarded(0);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace flexarm::solids
