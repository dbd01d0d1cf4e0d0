// The command line `dem`: parse, choose a verb, turn errors into one line and an exit code.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <numeric>

#include "verbs.h"

namespace dem::app {
namespace {

const char* kExamples = R"(
Examples:
  dem info N36E008.hgt                          what a file holds, and its voids
  dem fill N36E008.hgt filled.tif               fill the voids
  dem sample whole.tif sparse.tif --keep 3.4%   make a problem whose answer is known
  dem evaluate whole.tif filled.tif --known sparse.tif
  dem VERB --help                               options and examples of one verb

Exit codes: 0 done, 1 usage, 2 a file could not be read or written, 3 cells were left unfilled,
4 a check failed, 5 interrupted.)";

/// How many letters must change to make one word of the other (Levenshtein).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t swap = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, swap});
    }
  }
  return row.back();
}

/// "; did you mean X?" for the name nearest to `word`, or "" when none is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const auto& name : names)
    if (const auto d = distance(word, name); d < least) least = d, best = name;
  return best.empty() ? "" : "; did you mean " + best + "?";
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const auto* option : verb.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

int fail(Exit code, std::string message) {
  std::ranges::replace(message, '\n', ' ');
  fmt::print(stderr, "dem: {}\n", message);
  return code;
}

/// What CLI11 found wrong, in one line with a hint.
int fail_usage(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  const CLI::App& where = chosen.empty() ? app : *chosen.front();
  const std::string command = chosen.empty() ? "dem" : "dem " + where.get_name();
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    const auto extras = app.remaining(true);
    const std::string word = extras.empty() ? "" : extras.front();
    if (word.starts_with("-"))
      what = "unknown option " + word + suggestion(word, option_names(where));
    else
      what = "unexpected argument " + word;
  }
  return fail(kUsage, fmt::format("{} (see `{} --help`)", what, command));
}

/// An option before the verb that the program itself does not have.
int fail_early_option(const CLI::App& app, const std::string& word) {
  for (const auto* verb : app.get_subcommands({}))
    if (verb->get_option_no_throw(word))
      return fail(kUsage,
                  fmt::format("{0} belongs after the verb, like `dem {1} {0}` (see `dem --help`)",
                              word, verb->get_name()));
  return fail(kUsage, fmt::format("unknown option {}{} (see `dem --help`)", word,
                                  suggestion(word, option_names(app))));
}

int fail_unknown_verb(const CLI::App& app, const std::string& word) {
  const auto names = verb_names(app);
  return fail(kUsage, fmt::format("unknown verb {}{} (verbs: {})", word, suggestion(word, names),
                                  fmt::join(names, ", ")));
}

/// The command line as a shell takes it: words with spaces and other signs are quoted.
std::string command_line(int argc, char** argv) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  std::string line = "dem";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
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
  return fail(kFile, fmt::format("stdout: {}", std::strerror(errno)));
}

/// Runs the chosen verb; each kind of error has its exit code.
int run_verb(Shell& shell) {
  try {
    return flushed(shell.verb());
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

int run(int argc, char** argv) {
  install_signal_handlers();

  CLI::App app("Reconstruction of digital elevation models", "dem");
  app.set_version_flag("--version", std::string("dem ") + DEM_VERSION);
  app.footer(kExamples);
  app.get_formatter()->column_width(31);
  app.require_subcommand(1);
  Shell shell;
  shell.command = command_line(argc, argv);
  add_info(app, shell);
  add_sample(app, shell);
  add_fill(app, shell);
  add_grid(app, shell);
  add_check(app, shell);
  add_supersample(app, shell);
  add_deterrace(app, shell);
  add_evaluate(app, shell);
  add_curve(app, shell);
  add_reproduce(app, shell);
  add_generate(app, shell);
  add_erode(app, shell);
  add_render(app, shell);
  add_methods(app, shell);
  add_manual(app, shell);
  add_completion(app, shell);
  for (auto* verb : app.get_subcommands({})) shell.add_options(*verb);

  if (argc == 1) {
    fmt::print(stderr, "{}", app.help());
    return kUsage;
  }
  const std::string first = argv[1];
  if (first.starts_with("-") && !app.get_option_no_throw(first))
    return fail_early_option(app, first);
  if (!first.starts_with("-") && std::ranges::count(verb_names(app), first) == 0)
    return fail_unknown_verb(app, first);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return flushed(app.exit(help_or_version));
  } catch (const CLI::ParseError& error) {
    return fail_usage(app, error);
  } catch (const std::invalid_argument& error) {
    return fail(kUsage, error.what());
  }
  return run_verb(shell);
}

}  // namespace
}  // namespace dem::app

int main(int argc, char** argv) { return dem::app::run(argc, argv); }
