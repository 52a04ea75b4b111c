// SPDX-License-Identifier: Apache-2.0
#ifndef LS_WHERE_GLSL
#define LS_WHERE_GLSL

/// Runs the statement where `condition` holds: an `if` written as a loop of at most one round. A
/// driver that runs shaders on a CPU's vector unit (Mesa's llvmpipe) executes both sides of every
/// branch, but leaves a loop as soon as no lane is in it, so that vectors with nothing to do cost
/// nothing. Elsewhere it costs what an `if` does.
#define LS_WHERE(condition) \
    for (uint lsOnce = uint(condition), lsRound = 0; lsRound < lsOnce; ++lsRound)

#endif
