// SPDX-License-Identifier: Apache-2.0
#version 460
#include "params_test.h"

// Numbers the words of every shared struct by the names of their fields.
layout(local_size_x = 1) in;
layout(binding = 0, scalar) writeonly buffer All { AllParams all; };

uint last = 0;

void next(out uint value) { value = ++last; }
void next(out float value) { value = float(++last); }
void next(out vec2 v) { next(v.x); next(v.y); }
void next(out vec3 v) { next(v.x); next(v.y); next(v.z); }
void next(out vec4 v) { next(v.x); next(v.y); next(v.z); next(v.w); }
void next(out uvec2 v) { next(v.x); next(v.y); }
void next(out uvec3 v) { next(v.x); next(v.y); next(v.z); }
void next(out ivec2 v) { v.x = int(++last); v.y = int(++last); }
void next(out mat4 m) { next(m[0]); next(m[1]); next(m[2]); next(m[3]); }

void main() {
#define LS_WRITE(field) next(field);
    LS_VISIT_ALL(LS_WRITE, all)
}
