// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/describe/label_book.hpp"
#include "agent/reports/report_periods.hpp"
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

/// Collects what a description says beside the board's own words: link, agent, labels, numbers of elements,
/// and periods. note_...() returns true where the description changed, so that it must be announced. Pure.
class Describer {
  public:
    Describer(const Board& board, const model::ModelSet& models, const ReportOptions& reports);

    // Not announced by themselves: they are in the next description.
    void link_opened(model::LinkInfo link) { link_ = std::move(link); }
    void line_rate_changed(unsigned baud) { link_.baud = static_cast<int>(baud); }
    /// `changed`: it may be another board than before.
    void board_found(bool changed, const ReportPeriods& periods);
    /// The version of its sketch that the agent would load; 0: none. See protocol::version_text().
    void loadable_version(int version) { loadable_ = version; }
    bool note_agent(model::AgentInfo agent);
    bool note_labels(const LabelBook& labels);
    bool note_warnings(std::vector<std::string> warnings);
    bool note_stop(const std::optional<model::StopInfo>& stopped);
    /// A decoded event shows how many elements its service has.
    bool note_event(const std::string& name, const nlohmann::json& event);
    /// A request ended that may have changed pin modes and periods.
    bool note_settings(const ReportPeriods& periods);

    const model::LinkInfo& link() const { return link_; }
    /// For a board without any: from its port or address.
    std::string name_from_link() const;
    model::FirmwareInfo firmware() const;
    /// Without board name, session, seq and lease, which the announcer fills in.
    model::Description description();

  private:
    std::map<char, int> periods_of(const ReportPeriods& periods) const;
    model::PinsInfo pins() const;

    const Board& board_;
    const model::ModelSet& models_;
    model::LinkInfo link_;
    model::AgentInfo agent_;
    std::map<char, int> counts_;   // elements of a service, as seen in its events
    std::map<char, int> periods_;  // of reports, in ms
    model::Labels labels_;
    std::string labels_fault_;
    std::optional<model::OnDemandInfo> on_demand_;
    std::vector<std::string> warnings_;
    std::optional<model::StopInfo> stopped_;
    std::vector<protocol::PinMode> described_modes_;
    int loadable_ = 0;
};

}  // namespace asip::agent
