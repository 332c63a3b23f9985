#pragma once
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::sim {

/// Something wired to a board's pins. Owned by its Board; used only between the board's runs (or in its
/// callbacks).
class Part {
  public:
    virtual ~Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    const std::string& name() const { return name_; }
    /// "led", "button", ... as in a board file.
    virtual std::string_view kind() const = 0;

    /// What the part shows now, for a person and as the value in JSON: "on", "pressed", "0.5", "90".
    virtual std::string state() const = 0;

    /// Works the part: "press", "release", "set 0.25". An error says what this part understands.
    virtual Expected<void> command(std::string_view verb, std::string_view argument) = 0;

    /// The board was reset and has forgotten its timers: start over what runs by time. Levels are driven
    /// again already.
    virtual void after_reset() {}

  protected:
    explicit Part(std::string name) : name_(std::move(name)) {}

  private:
    std::string name_;
};

}  // namespace asip::sim
