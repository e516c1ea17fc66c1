#pragma once

// A function with this mark uses vectors as wide as the machine allows. It must compute each entry
// independently, so that the numbers do not depend on the width. The width is chosen when the
// program is loaded, before ThreadSanitizer is ready.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define FLUIDCARVE_WIDE __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define FLUIDCARVE_WIDE
#endif

// Marks a function or lambda that a FLUIDCARVE_WIDE function calls. It must be inlined: g++
// compiles a separate function for any machine, without the wide vectors.
#define FLUIDCARVE_INLINED __attribute__((always_inline))
#define FLUIDCARVE_INLINE inline FLUIDCARVE_INLINED
