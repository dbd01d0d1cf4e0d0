#pragma once
// The text of --help.

#include <string>

#include "cli/command.h"

namespace dem::app {

std::string help_text(const Program& program);
std::string help_text(const Command& command);

/// What is said of an option after its doc: "; may be repeated", "; required", " [default]".
std::string remarks(const Option& option);

}  // namespace dem::app
