// dem manual and dem completion: what the parser knows, as pages and as scripts for shells.

#include <CLI/CLI.hpp>

#include "manual/completion.h"
#include "manual/outline.h"
#include "manual/pages.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string verb, format = "man";
};

int manual(const Options& o, CLI::App& app, Shell& shell) {
  const auto verbs = outline(app);
  const bool man = o.format == "man";
  std::string page;
  if (o.verb.empty())
    page = man ? man_page(verbs, app.get_description(), app.get_footer())
               : markdown_page(verbs, app.get_description(), app.get_footer());
  else
    page = man ? man_page(find_verb(verbs, o.verb)) : markdown_page(find_verb(verbs, o.verb));
  shell.print({{"format", o.format}, {"page", page}}, page);
  return kDone;
}

int write_completion(const std::string& name, CLI::App& app, Shell& shell) {
  const std::string script = completion(name, outline(app));
  shell.print({{"shell", name}, {"script", script}}, script);
  return kDone;
}

}  // namespace

void add_manual(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb = add_verb(app, shell, "manual", "The page of a verb, for man or in Markdown",
                        "  dem manual fill | man -l -\n"
                        "  dem manual fill --format markdown > fill.md",
                        [o, &app, &shell] { return manual(*o, app, shell); });
  verb->add_option("VERB", o->verb, "one of the verbs; the program's own page when left out")
      ->type_name("");
  verb->add_option("--format", o->format, "man or markdown")
      ->check(one_of({"man", "markdown"}))
      ->type_name("NAME")
      ->capture_default_str();
}

void add_completion(CLI::App& app, Shell& shell) {
  const auto name = std::make_shared<std::string>();
  auto* verb = add_verb(app, shell, "completion", "A script that completes `dem` in a shell",
                        "  source <(dem completion bash)      # in ~/.bashrc\n"
                        "  source <(dem completion zsh)       # in ~/.zshrc, after compinit\n"
                        "  dem completion fish | source       # in ~/.config/fish/config.fish",
                        [name, &app, &shell] { return write_completion(*name, app, shell); });
  verb->add_option("SHELL", *name, "bash, zsh or fish")
      ->required()
      ->check(one_of(shells()))
      ->type_name("");
}

}  // namespace dem::app
