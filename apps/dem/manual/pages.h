#pragma once
// A page of the manual for each verb, and one for the program.

#include <string>

#include "cli/command.h"

namespace dem::app {

/// In roff, for man.
std::string man_page(const Command& verb);
std::string man_page(const Program& program);

/// In Markdown.
std::string markdown_page(const Command& verb);
std::string markdown_page(const Program& program);

}  // namespace dem::app
