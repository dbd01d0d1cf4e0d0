#pragma once
// A page of the manual for each verb, and one for the program.

#include <string>
#include <vector>

#include "manual/outline.h"

namespace dem::app {

/// In roff, for man. `about` and `footer` are those of the program's help.
std::string man_page(const VerbOutline& verb);
std::string man_page(const std::vector<VerbOutline>& verbs, const std::string& about,
                     const std::string& footer);

/// In Markdown.
std::string markdown_page(const VerbOutline& verb);
std::string markdown_page(const std::vector<VerbOutline>& verbs, const std::string& about,
                          const std::string& footer);

}  // namespace dem::app
