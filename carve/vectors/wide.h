#pragma once

// A function with this mark uses vectors as wide as the machine allows. It must compute each entry
// by itself, so that the numbers are the same. The choice is made as the program is loaded, before
// ThreadSanitizer is ready.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define FLUIDCARVE_WIDE __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define FLUIDCARVE_WIDE
#endif

// A function or lambda that is called by one with that mark. A call would leave the wide vectors:
// g++ compiles what is not inlined for any machine.
#define FLUIDCARVE_INLINED __attribute__((always_inline))
#define FLUIDCARVE_INLINE inline FLUIDCARVE_INLINED
