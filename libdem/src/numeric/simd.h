#pragma once
// Loops over a row in the widest registers the machine has. Private to the library.

// Several versions of a hot loop, the best chosen when the program starts. None fuses multiply and
// add, so all give the same bits. Versions are chosen before the sanitizers' run time is up, so
// these do without.
#if defined(__x86_64__) && defined(__linux__) && defined(__OPTIMIZE__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(DEM_SANITIZED)
#define DEM_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define DEM_VECTORISED
#endif
#define DEM_INLINE __attribute__((always_inline))
#if defined(__clang__)
#define DEM_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__) && defined(__OPTIMIZE__)
#define DEM_INDEPENDENT _Pragma("GCC ivdep")
#else
#define DEM_INDEPENDENT
#endif
