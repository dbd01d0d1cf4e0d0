#pragma once
// One function per verb, in a file of its own or with its kin: it adds the verb to the program.

#include "common.h"

namespace dem::app {

// Headings of verbs in the help of the program.
inline constexpr const char *kEveryday = "Everyday", *kMeasure = "Measure",
                            *kSynthesize = "Synthesize", *kAbout = "About";

void add_info(Program& program, Shell& shell);
void add_fill(Program& program, Shell& shell);
void add_grid(Program& program, Shell& shell);
void add_supersample(Program& program, Shell& shell);
void add_deterrace(Program& program, Shell& shell);
void add_render(Program& program, Shell& shell);
void add_check(Program& program, Shell& shell);
void add_sample(Program& program, Shell& shell);
void add_evaluate(Program& program, Shell& shell);
void add_curve(Program& program, Shell& shell);
void add_reproduce(Program& program, Shell& shell);
void add_generate(Program& program, Shell& shell);
void add_erode(Program& program, Shell& shell);
void add_methods(Program& program, Shell& shell);
void add_manual(Program& program, Shell& shell);
void add_completion(Program& program, Shell& shell);

}  // namespace dem::app
