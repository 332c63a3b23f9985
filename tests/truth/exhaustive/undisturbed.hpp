// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/truth/exhaustive/trial.hpp"

namespace truth {

/// The history of a scenario in which nothing goes wrong, and its steps, from which others go on that differ
/// from there on only. What it was made of must outlive it.
class Undisturbed {
  public:
    explicit Undisturbed(const Scenario& scenario);

    struct Step {
        std::unique_ptr<const Trial> before;
        std::unique_ptr<const Firmware::Saved> firmware;
    };

    /// How it ended.
    const TrialEnd& end() const { return end_; }
    /// Those in which faults may come, as time passes.
    const std::vector<Step>& steps() const { return steps_; }
    /// In which of them the first of these comes; kPowerUp: before them.
    std::size_t step_of(const Faults& faults) const;
    static constexpr std::size_t kPowerUp = SIZE_MAX;
    /// As run_trial(), in less time.
    TrialEnd run(const Faults& faults);
    const Scenario& scenario() const { return scenario_; }

  private:
    const Scenario& scenario_;
    TrialEnd end_;
    std::vector<Step> steps_;
    std::unique_ptr<Trial> trial_;
};

}  // namespace truth
