// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/key_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

// The limits of a range, with at most six digits.
std::string Plain(double value) { return fmt::format("{:g}", value); }

// A value as a person writes it: with the fewest digits that give it back. At most 15 of them, which hides
// the rounding of a conversion between units.
std::string PlainValue(double value) {
  constexpr int kFewest = 6;
  constexpr int kMost = 15;
  std::string text;
  for (int digits = kFewest; digits <= kMost; ++digits) {
    text = fmt::format("{:.{}g}", value, digits);
    if (std::stod(text) == value) {
      break;
    }
  }
  return text;
}

std::string Range(double min, double max) { return fmt::format("{} to {}", Plain(min), Plain(max)); }

[[noreturn]] void Refuse(const Setting& setting, const Key& key) {
  const std::string unit = key.unit.empty() ? "" : " " + key.unit;
  throw InputError(fmt::format("{}: {} = {} is not allowed: expected {}, {}{}", setting.where, setting.key,
                               ToText(setting.value), key.kind, key.allowed, unit));
}

bool ToDouble(const Value& value, double& number) {
  if (const auto* floating = std::get_if<double>(&value)) {
    number = *floating;
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    number = static_cast<double>(*integer);
  } else {
    return false;
  }
  return std::isfinite(number);
}

int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = std::exchange(row[0], static_cast<int>(i) + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int replace = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// "" when none is near.
std::string Nearest(const std::string& name, const std::vector<std::string>& names) {
  std::string best;
  int best_distance = std::max(3, static_cast<int>(name.size()) / 3) + 1;
  for (const std::string& candidate : names) {
    const int distance = EditDistance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace

void KeyTable::Add(Key key) { keys_.push_back(std::move(key)); }

void KeyTable::Number(std::string name, double& field, double min, double max, std::string unit,
                      std::string meaning) {
  Number(std::move(name), field, min, max, std::move(unit), std::move(meaning),
         [&field](double number) { field = number; });
}

void KeyTable::Number(std::string name, double value, double min, double max, std::string unit,
                      std::string meaning, std::function<void(double)> set) {
  Key key{std::move(name),   "a number", std::move(unit), Range(min, max), std::move(meaning),
          PlainValue(value), {}};
  key.set = [key, min, max, set = std::move(set)](const Setting& setting) {
    double number = 0.0;
    if (!ToDouble(setting.value, number) || number < min || number > max) {
      Refuse(setting, key);
    }
    set(number);
  };
  Add(std::move(key));
}

void KeyTable::Integer(std::string name, int& field, int min, int max, std::string unit,
                       std::string meaning) {
  Integer(std::move(name), field, min, max, std::move(unit), std::move(meaning),
          [&field](int number) { field = number; });
}

void KeyTable::Integer(std::string name, int value, int min, int max, std::string unit, std::string meaning,
                       std::function<void(int)> set) {
  Key key{std::move(name),
          "a whole number",
          std::move(unit),
          fmt::format("{} to {}", min, max),
          std::move(meaning),
          fmt::format("{}", value),
          {}};
  key.set = [key, min, max, set = std::move(set)](const Setting& setting) {
    const auto* integer = std::get_if<std::int64_t>(&setting.value);
    if (integer == nullptr || *integer < min || *integer > max) {
      Refuse(setting, key);
    }
    set(static_cast<int>(*integer));
  };
  Add(std::move(key));
}

void KeyTable::Flag(std::string name, bool& field, std::string meaning) {
  Key key{std::move(name), "a flag", "", "true or false", std::move(meaning), field ? "true" : "false", {}};
  key.set = [key, &field](const Setting& setting) {
    const auto* flag = std::get_if<bool>(&setting.value);
    if (flag == nullptr) {
      Refuse(setting, key);
    }
    field = *flag;
  };
  Add(std::move(key));
}

void KeyTable::Text(std::string name, std::string& field, std::string meaning) {
  Key key{std::move(name), "a text", "", "in quotes", std::move(meaning), ToText(field), {}};
  key.set = [key, &field](const Setting& setting) {
    const auto* text = std::get_if<std::string>(&setting.value);
    if (text == nullptr) {
      Refuse(setting, key);
    }
    field = *text;
  };
  Add(std::move(key));
}

void KeyTable::Choice(std::string name, std::string& field, std::vector<std::string> choices,
                      std::string meaning) {
  const auto chosen =
      static_cast<std::size_t>(std::find(choices.begin(), choices.end(), field) - choices.begin());
  AddChoice(std::move(name), chosen, choices, std::move(meaning),
            [&field, choices](std::size_t index) { field = choices[index]; });
}

void KeyTable::AddChoice(std::string name, std::size_t chosen, std::vector<std::string> choices,
                         std::string meaning, std::function<void(std::size_t chosen)> set) {
  Key key{std::move(name),
          "one of",
          "",
          fmt::format("\"{}\"", fmt::join(choices, "\", \"")),
          std::move(meaning),
          fmt::format("\"{}\"", choices.at(chosen)),
          {}};
  key.set = [key, choices, set = std::move(set)](const Setting& setting) {
    const auto* text = std::get_if<std::string>(&setting.value);
    const auto found = text == nullptr ? choices.end() : std::find(choices.begin(), choices.end(), *text);
    if (found == choices.end()) {
      Refuse(setting, key);
    }
    set(static_cast<std::size_t>(found - choices.begin()));
  };
  Add(std::move(key));
}

void KeyTable::Numbers(std::string name, std::vector<double>& field, std::size_t size_min,
                       std::size_t size_max, double min, double max, std::string unit, std::string meaning) {
  Numbers(std::move(name), field, size_min, size_max, min, max, std::move(unit), std::move(meaning),
          [&field](const std::vector<double>& numbers) { field = numbers; });
}

void KeyTable::Numbers(std::string name, const std::vector<double>& values, std::size_t size_min,
                       std::size_t size_max, double min, double max, std::string unit, std::string meaning,
                       std::function<void(const std::vector<double>&)> set) {
  const std::string count =
      size_min == size_max ? fmt::format("{}", size_min) : fmt::format("{} to {}", size_min, size_max);
  Key key{std::move(name),
          "a list of " + count + " numbers",
          std::move(unit),
          "each " + Range(min, max),
          std::move(meaning),
          ToText(values),
          {}};
  key.set = [key, size_min, size_max, min, max, set = std::move(set)](const Setting& setting) {
    const auto* numbers = std::get_if<std::vector<double>>(&setting.value);
    if (numbers == nullptr || numbers->size() < size_min || numbers->size() > size_max) {
      Refuse(setting, key);
    }
    for (const double number : *numbers) {
      if (!std::isfinite(number) || number < min || number > max) {
        Refuse(setting, key);
      }
    }
    set(*numbers);
  };
  Add(std::move(key));
}

void KeyTable::OneOrMore(std::string name, std::vector<double>& field, std::size_t size_max, double min,
                         double max, std::string unit, std::string meaning) {
  Key key{std::move(name),
          fmt::format("a number, or a list of 1 to {} numbers", size_max),
          std::move(unit),
          "each " + Range(min, max),
          std::move(meaning),
          ToText(field),
          {}};
  key.set = [key, size_max, min, max, &field](const Setting& setting) {
    std::vector<double> numbers(1);
    if (const auto* list = std::get_if<std::vector<double>>(&setting.value)) {
      numbers = *list;
    } else if (!ToDouble(setting.value, numbers[0])) {
      Refuse(setting, key);
    }
    const bool fits = std::all_of(numbers.begin(), numbers.end(), [min, max](double number) {
      return std::isfinite(number) && number >= min && number <= max;
    });
    if (!fits || numbers.empty() || numbers.size() > size_max) {
      Refuse(setting, key);
    }
    field = numbers;
  };
  Add(std::move(key));
}

void KeyTable::Renamed(std::string former, std::string successor) {
  successors_[std::move(former)] = std::move(successor);
}

const std::string& KeyTable::NameToday(const std::string& name) const {
  const auto renamed = successors_.find(name);
  return renamed == successors_.end() ? name : renamed->second;
}

void KeyTable::Apply(const Setting& setting) const {
  if (const std::string& today = NameToday(setting.key); today != setting.key) {
    throw InputError(fmt::format("{}: the key {} is called {} now", setting.where, setting.key, today));
  }
  std::vector<std::string> names;
  for (const Key& key : keys_) {
    if (key.name == setting.key) {
      key.set(setting);
      return;
    }
    names.push_back(key.name);
  }
  throw InputError(
      fmt::format("{}: unknown key {}{}", setting.where, setting.key, DidYouMean(setting.key, names)));
}

std::map<std::string, std::string> KeyTable::Values() const {
  std::map<std::string, std::string> values;
  for (const Key& key : keys_) {
    values[key.name] = key.default_text;
  }
  return values;
}

std::string DidYouMean(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = Nearest(name, names);
  return nearest.empty() ? nearest : "; did you mean " + nearest + "?";
}

std::set<std::string> KeyTable::ApplyRecorded(const std::map<std::string, std::string>& recorded) const {
  std::map<std::string, std::string> values;
  for (const auto& [name, text] : recorded) {
    values[NameToday(name)] = text;
  }
  std::set<std::string> applied;
  for (const Key& key : keys_) {
    const auto text = values.find(key.name);
    if (text == values.end()) {
      continue;
    }
    if (text->second != key.default_text) {
      Apply(ParseAssignment(key.name + "=" + text->second));
    }
    applied.insert(key.name);
  }
  return applied;
}

}  // namespace fovea::config
