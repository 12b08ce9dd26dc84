#include "flexarm/lanes/kernel_code.hpp"

namespace flexarm::lanes {

struct Avx2;
extern const Kernel kernels_avx2[] = {KernelCode<2, 4, Avx2>::kernel, KernelCode<3, 4, Avx2>::kernel};

}  // namespace flexarm::lanes
