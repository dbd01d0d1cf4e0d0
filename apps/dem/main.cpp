// The command line `dem`: choose a verb, run it, turn errors into one line and an exit code.

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "cli/help.h"
#include "cli/parser.h"
#include "verbs.h"

namespace dem::app {
namespace {

const char* kExamples =
    "  dem info N36E008.hgt                          what a file holds, and its voids\n"
    "  dem fill N36E008.hgt filled.tif               fill the voids\n"
    "  dem sample whole.tif sparse.tif --keep 3.4%   make a test problem whose answer is known\n"
    "  dem evaluate whole.tif filled.tif --known sparse.tif\n"
    "  dem VERB --help                               options and examples of one verb\n";

const char* kExitCodes =
    "Exit codes: 0 done, 1 wrong usage, 2 a file could not be read or written, 3 cells are left\n"
    "unfilled, 4 a check failed, 5 interrupted.\n";

int fail(Exit code, std::string message) {
  std::ranges::replace(message, '\n', ' ');
  fmt::print(stderr, "dem: {}\n", message);
  return code;
}

/// An option before the verb that the program itself does not have.
int fail_early_option(Program& program, const std::string& word) {
  for (Command& verb : program.commands)
    if (verb.find(word))
      return fail(kUsage, fmt::format("{0} comes after the verb, as in `dem {1} {0}` (see `dem "
                                      "--help`)",
                                      word, verb.name));
  return fail(kUsage, fmt::format("unknown option {}{} (see `dem --help`)", word,
                                  suggestion(word, {"--help", "--version"})));
}

int fail_unknown_verb(const Program& program, const std::string& word) {
  const auto names = program.names();
  return fail(kUsage, fmt::format("unknown verb {}{} (verbs: {})", word, suggestion(word, names),
                                  fmt::join(names, ", ")));
}

/// The command line as a shell takes it: words with spaces and other signs are quoted.
std::string command_line(const std::vector<std::string>& words) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  std::string line = "dem";
  for (const std::string& word : words) {
    line += ' ';
    if (!word.empty() && word.find_first_not_of(plain) == word.npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) c == '\'' ? line += "'\\''" : line += c;
    line += '\'';
  }
  return line;
}

/// `code`, unless what was printed could not be written.
int flushed(int code) {
  if (std::fflush(stdout) == 0) return code;
  return fail(kFile, fmt::format("standard output: {}", std::strerror(errno)));
}

int print(const std::string& text) {
  fmt::print("{}", text);
  return flushed(kDone);
}

/// Reads the options of the verb and runs it; each kind of error has its exit code.
int run_verb(Command& verb, const std::vector<std::string>& words, Shell& shell) {
  try {
    if (parse(verb, words) == Parsed::help_wanted) return print(help_text(verb));
    return flushed(verb.work());
  } catch (const Cancelled&) {
    shell.clear_bar();
    return fail(kInterrupted, "interrupted; no output was changed");
  } catch (const std::invalid_argument& error) {
    shell.clear_bar();
    return fail(kUsage, error.what());
  } catch (const IoError& error) {
    shell.clear_bar();
    const std::string& field = error.field();
    return fail(kFile, field.empty() ? error.what()
                                     : fmt::format("{} ({})", error.what(), option_of(field)));
  } catch (const std::bad_alloc&) {
    shell.clear_bar();
    return fail(kFile, "not enough memory for a raster of this size");
  } catch (const std::exception& error) {
    shell.clear_bar();
    return fail(kFile, error.what());
  }
}

int run(const std::vector<std::string>& words) {
  install_signal_handlers();

  Program program{"Reconstruction of digital elevation models", kExamples, kExitCodes, {}};
  Shell shell;
  shell.command = command_line(words);
  add_info(program, shell);
  add_fill(program, shell);
  add_grid(program, shell);
  add_supersample(program, shell);
  add_deterrace(program, shell);
  add_render(program, shell);
  add_check(program, shell);
  add_sample(program, shell);
  add_evaluate(program, shell);
  add_curve(program, shell);
  add_reproduce(program, shell);
  add_generate(program, shell);
  add_erode(program, shell);
  add_methods(program, shell);
  add_manual(program, shell);
  add_completion(program, shell);
  for (Command& verb : program.commands) shell.add_options(verb);

  if (words.empty()) {
    fmt::print(stderr, "{}", help_text(program));
    return kUsage;
  }
  const std::string& first = words.front();
  if (first == "--help" || first == "-h") return print(help_text(program));
  if (first == "--version") return print(fmt::format("dem {}\n", DEM_VERSION));
  if (first.starts_with("-")) return fail_early_option(program, first);
  const auto verb = std::ranges::find(program.commands, first, &Command::name);
  if (verb == program.commands.end()) return fail_unknown_verb(program, first);
  return run_verb(*verb, {words.begin() + 1, words.end()}, shell);
}

}  // namespace
}  // namespace dem::app

int main(int argc, char** argv) { return dem::app::run({argv + 1, argv + argc}); }
