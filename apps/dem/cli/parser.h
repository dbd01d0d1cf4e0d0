#pragma once
// Words of a command line to the options of a verb.

#include <stdexcept>
#include <string>
#include <vector>

#include "cli/command.h"

namespace dem::app {

/// A command line that says nothing the program can do: what is wrong, and where help is.
class UsageError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

enum class Parsed { all, help_wanted };

/// Gives the words after the verb to its options and arguments. `--option value`, `--option=value`,
/// `-o value`, `-ovalue`, `-abc` for switches; after `--` every word is an argument.
/// Throws UsageError, and std::invalid_argument for a value that its option refuses.
Parsed parse(Command& command, const std::vector<std::string>& words);

/// "; did you mean X?" for the name nearest to `word`, or "" when none is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& names);

}  // namespace dem::app
