#include "runtime/run/freed_memory.h"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <climits>

namespace fluidcarve {

void keep_freed_memory() {
#if defined(__GLIBC__)
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace fluidcarve
