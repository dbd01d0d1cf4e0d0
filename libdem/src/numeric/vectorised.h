#pragma once
// Loops over a row in the widest registers the machine has. Private to the library.

// Function versions are chosen before the sanitizers' run time is up, so they do without.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(DEM_SANITIZED)
#define DEM_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define DEM_VECTORISED
#endif
