#include <functional>
#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/plain_help.h"

namespace station {
namespace {

// A command with its own commands and options, by the words that lead to it: "threadstation scatter eval".
using Visit = std::function<void(const std::string& words, const CLI::App& command)>;

void each_command(const std::string& words, const CLI::App& command, const Visit& visit) {
  visit(words, command);
  for (const CLI::App* part : command.get_subcommands(is_listed))
    each_command(words + " " + part->get_name(), *part, visit);
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

// Shell code that follows the words of the line to the command that they lead to, in the variable `at`.
std::string steps(const CLI::App& app, const std::string& name, const std::string& word) {
  std::string text = "    case \"$at " + word + "\" in\n";
  each_command(name, app, [&](const std::string& words, const CLI::App& command) {
    if (command.get_parent()) text += "      \"" + words + "\") at=\"" + words + "\" ;;\n";
  });
  return text + "    esac\n";
}

// The cases of options that take one of a few words; `say` makes shell code of the words.
std::string cases_of_words(const CLI::App& app, const std::string& name,
                           const std::function<std::string(const std::string&)>& say) {
  std::string text;
  each_command(name, app, [&](const std::string& words, const CLI::App& command) {
    for (const CLI::Option* option : options_of(command)) {
      std::string choices;
      for (const std::string& word : words_of(*option)) choices += (choices.empty() ? "" : " ") + word;
      if (!choices.empty()) text += "    \"" + words + " " + typed_name(*option) + "\") " + say(choices) + " ;;\n";
    }
  });
  return text;
}

std::string for_bash(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string text = "# bash completion for " + name + "\n_" + name + "() {\n  local at=" + name +
                     " i words=\n  COMPREPLY=()\n  for ((i = 1; i < COMP_CWORD; ++i)); do\n" +
                     steps(app, name, "${COMP_WORDS[i]}") + "  done\n  case \"$at ${COMP_WORDS[COMP_CWORD-1]}\" in\n" +
                     cases_of_words(app, name, [](const std::string& words) { return "words=\"" + words + "\""; }) +
                     "  esac\n  [ -n \"$words\" ] || case \"$at\" in\n";
  each_command(name, app, [&](const std::string& words, const CLI::App& command) {
    text += "    \"" + words + "\")\n      case \"${COMP_WORDS[COMP_CWORD]}\" in\n        -*) words=\"";
    for (const CLI::Option* option : options_of(command)) text += typed_name(*option) + " ";
    text += "\" ;;\n        *) words=\"";
    for (const CLI::App* part : command.get_subcommands(is_listed)) text += part->get_name() + " ";
    text += "\" ;;\n      esac ;;\n";
  });
  return text +
         "  esac\n"
         "  # shellcheck disable=SC2207\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
         "}\n"
         "complete -o default -F _" +
         name + " " + name + "\n";
}

// In single quotes, with the colon that _describe puts between a word and what it means.
std::string described(const std::string& word, const std::string& meaning) {
  std::string text;
  for (const char c : meaning) text += c == '\'' ? "'\\''" : std::string(1, c);
  return "'" + word + ":" + text + "' ";
}

std::string for_zsh(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string text = "#compdef " + name + "\n_" + name + "() {\n  local at=" + name +
                     " i\n  local -a commands options choices\n  for ((i = 2; i < CURRENT; ++i)); do\n" +
                     steps(app, name, "${words[i]}") + "  done\n  case \"$at ${words[CURRENT-1]}\" in\n" +
                     cases_of_words(app, name, [](const std::string& words) { return "choices=(" + words + ")"; }) +
                     "  esac\n  if (( ${#choices} )); then\n    _describe word choices\n    return\n  fi\n"
                     "  case \"$at\" in\n";
  each_command(name, app, [&](const std::string& words, const CLI::App& command) {
    text += "    \"" + words + "\")\n      commands=(";
    for (const CLI::App* part : command.get_subcommands(is_listed))
      text += described(part->get_name(), part->get_description());
    text += ")\n      options=(";
    for (const CLI::Option* option : options_of(command))
      text += described(typed_name(*option), option->get_description());
    text += ") ;;\n";
  });
  return text +
         "  esac\n"
         "  if [[ ${words[CURRENT]} == -* ]]; then\n    _describe option options\n"
         "  elif (( ${#commands} )); then\n    _describe command commands\n"
         "  else\n    _files\n  fi\n}\n_" +
         name + " \"$@\"\n";
}

}  // namespace

void add_completion_command(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("completion", "print what lets a shell complete this program's words");
  command->add_option("shell", *shell, "whose language it is in")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->callback([shell, &app] { std::cout << (*shell == "bash" ? for_bash(app) : for_zsh(app)); });
}

}  // namespace station
