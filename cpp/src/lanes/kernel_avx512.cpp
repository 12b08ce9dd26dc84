#include "flexarm/lanes/kernel_code.hpp"

namespace flexarm::lanes {

struct Avx512;
extern const Kernel kernels_avx512[] = {KernelCode<2, 8, Avx512>::kernel, KernelCode<3, 8, Avx512>::kernel};

}  // namespace flexarm::lanes
