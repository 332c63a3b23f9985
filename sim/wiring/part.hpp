// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "sim/wiring/part_kind.hpp"

namespace asip::sim {

/// Something wired to a board's pins. Owned by its Board; used only between the board's runs (or in its
/// callbacks).
class Part {
  public:
    virtual ~Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    const std::string& name() const { return name_; }
    const PartKind& kind() const { return kind_; }

    /// What the part shows now, for a person and as the value in JSON: "on", "pressed", "0.5", "90".
    virtual std::string state() const = 0;

    /// Carries out a command: "press", "release", "set" with "0.25". Errors: the kind has no such
    /// verb (it names those that there are), an argument where none is taken, or one that is out of range.
    Expected<void> command(std::string_view verb, std::string_view argument);

    /// The board was reset and has forgotten its timers: restart what runs by time. Levels are driven
    /// again already.
    virtual void after_reset() {}

  protected:
    Part(std::string name, const PartKind& kind) : name_(std::move(name)), kind_(kind) {}

  private:
    /// `verb` is one of the kind's; `argument` is empty where that takes none.
    virtual Expected<void> perform(std::string_view verb, std::string_view argument);

    std::string name_;
    const PartKind& kind_;
};

}  // namespace asip::sim
