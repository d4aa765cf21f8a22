#pragma once

#include <string>
#include <vector>

#include "command_text.hpp"

/// The scripts of the single shells, and what they have in common.
namespace resilin::cli {

std::string bash_completion(const ProgramText& program);
std::string zsh_completion(const ProgramText& program);
std::string fish_completion(const ProgramText& program);

/// The options as words: "--out", and of a flag that may have a value "--resume=anyway" as well.
std::vector<std::string> option_words(const std::vector<OptionText>& options);

/// `text` with `escape` before each character of `special`.
std::string escaped(const std::string& text, const std::string& special, const std::string& escape = "\\");

/// Between single quotes, for shells of the kind of sh.
std::string quoted_for_shell(const std::string& text);

/// Text of an option in a list: the first sentence of its help.
std::string first_sentence(const std::string& help);

/// Whether some words stop at '=' and go on with a value.
bool has_pairs(const std::vector<std::string>& words);

}  // namespace resilin::cli
