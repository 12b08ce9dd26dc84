#include "flexarm/lanes/numbers.hpp"

namespace flexarm::lanes {

#ifdef FLEXARM_LANES
extern const Kernel kernels_avx512[2], kernels_avx2[2];  // of the plane, of space

const Kernel* kernel_for(int dimension, int arms) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return nullptr;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
  return (wide && arms > kernels_avx2->lanes ? kernels_avx512 : kernels_avx2) + (dimension - 2);
}
#else
const Kernel* kernel_for(int, int) { return nullptr; }
#endif

}  // namespace flexarm::lanes
