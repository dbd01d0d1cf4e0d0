#pragma once
// Scripts that complete the command line in a shell.

#include <string>
#include <vector>

#include "cli/command.h"

namespace dem::app {

/// For shells named "bash", "zsh" and "fish".
std::vector<std::string> shells();
std::string completion(const std::string& shell, const Program& program);

}  // namespace dem::app
