#pragma once
// The command line as plain values, read off the parser itself: manual pages, completion and other
// programs are made from it, so none of them can say anything else than the parser does.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace dem::app {

/// An option, or an argument by position.
struct ArgumentOutline {
  std::vector<std::string> names;  ///< {"-m", "--method"}; by position: {"IN"}
  std::string value;               ///< what stands for its value, "NAME"; "": a switch
  std::string doc;                 ///< one line
  std::string group;               ///< heading in the help
  std::string default_text;        ///< "" when there is none
  std::string takes;               ///< kind of value as takes() has it (common.h); "" any text
  std::vector<std::string> choices;
  bool required = false, repeats = false;
};

struct VerbOutline {
  std::string name, summary;
  std::vector<ArgumentOutline> arguments, options;
  std::string footer;  ///< examples and notes, as the help ends with them

  std::string synopsis() const;  ///< "dem fill [OPTIONS] IN OUT"
};

/// The verbs, in the order of the help.
std::vector<VerbOutline> outline(CLI::App& app);

/// The verb called `name`; throws std::invalid_argument that lists the names there are.
const VerbOutline& find_verb(const std::vector<VerbOutline>& verbs, const std::string& name);

/// The options' groups, in the order in which they come.
std::vector<std::string> groups(const VerbOutline& verb);

}  // namespace dem::app
