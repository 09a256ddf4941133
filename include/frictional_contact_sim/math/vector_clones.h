#pragma once
/**
 * @file vector_clones.h
 * @brief VECTOR_CLONES in front of a free function: compiled for wider vector units too, chosen when the library loads.
 *
 * Debian's baseline is SSE2; on x86-64 GCC adds an AVX2 clone. Loops that sum are to be written with a fixed number of
 * accumulators, and AVX2 alone fuses no multiplication with an addition: every clone gives the same bits.
 * Not under ThreadSanitizer: what chooses runs before it is there, instrumented.
 */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define VECTOR_CLONES
#endif
