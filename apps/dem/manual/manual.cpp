// dem manual and dem completion: the command line as pages and as scripts for shells.

#include "manual/completion.h"
#include "manual/pages.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string verb, format = "man";
};

int manual(const Options& o, const Program& program, Shell& shell) {
  const bool man = o.format == "man";
  std::string page;
  if (o.verb.empty())
    page = man ? man_page(program) : markdown_page(program);
  else
    page = man ? man_page(program.find(o.verb)) : markdown_page(program.find(o.verb));
  shell.print({{"format", o.format}, {"page", page}}, page);
  return kDone;
}

int write_completion(const std::string& name, const Program& program, Shell& shell) {
  const std::string script = completion(name, program);
  shell.print({{"shell", name}, {"script", script}}, script);
  return kDone;
}

}  // namespace

void add_manual(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add("manual", kAbout, "Print the manual page of a verb",
                              "  dem manual fill | man -l -\n"
                              "  dem manual fill --format markdown > fill.md");
  verb.work = [o, &program, &shell] { return manual(*o, program, shell); };
  verb.argument("VERB", o->verb, "Name of a verb (the page of the program itself)");
  verb.option("--format", o->format, "NAME", "man or markdown")
      .one_of({"man", "markdown"})
      .show_default();
}

void add_completion(Program& program, Shell& shell) {
  const auto name = std::make_shared<std::string>();
  Command& verb =
      program.add("completion", kAbout, "Print a script that completes `dem` in a shell",
                  "  source <(dem completion bash)      # in ~/.bashrc\n"
                  "  source <(dem completion zsh)       # in ~/.zshrc, after compinit\n"
                  "  dem completion fish | source       # in ~/.config/fish/config.fish");
  verb.work = [name, &program, &shell] { return write_completion(*name, program, shell); };
  verb.argument("SHELL", *name, "Name of the shell: bash, zsh or fish")
      .one_of(shells())
      .must_be_given();
}

}  // namespace dem::app
