#pragma once
// One function per verb, in a file of its own or with its kin: it adds the verb to the command
// line.

#include "common.h"

namespace dem::app {

void add_info(CLI::App& app, Shell& shell);
void add_sample(CLI::App& app, Shell& shell);
void add_fill(CLI::App& app, Shell& shell);
void add_grid(CLI::App& app, Shell& shell);
void add_check(CLI::App& app, Shell& shell);
void add_supersample(CLI::App& app, Shell& shell);
void add_deterrace(CLI::App& app, Shell& shell);
void add_evaluate(CLI::App& app, Shell& shell);
void add_curve(CLI::App& app, Shell& shell);
void add_reproduce(CLI::App& app, Shell& shell);
void add_generate(CLI::App& app, Shell& shell);
void add_erode(CLI::App& app, Shell& shell);
void add_render(CLI::App& app, Shell& shell);
void add_methods(CLI::App& app, Shell& shell);
void add_manual(CLI::App& app, Shell& shell);
void add_completion(CLI::App& app, Shell& shell);

}  // namespace dem::app
