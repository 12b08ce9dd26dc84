#include "flexarm/lanes/numbers.hpp"

namespace flexarm::lanes {

#ifdef FLEXARM_LANES
extern const Kernel kernel_avx512, kernel_avx2;

const Kernel* kernel_for(int arms) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return nullptr;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
  return wide && arms > kernel_avx2.lanes ? &kernel_avx512 : &kernel_avx2;
}
#else
const Kernel* kernel_for(int) { return nullptr; }
#endif

}  // namespace flexarm::lanes
