// SPDX-License-Identifier: Apache-2.0
#include "asip/session/request.hpp"

#include <string_view>

#include "asip/protocol/board_info.hpp"
#include "asip/protocol/body.hpp"

namespace asip::session {

bool is_question(char service, char tag) {
    const std::string_view tags = service == '#' ? "?NSXIE" : service == 'I' ? "MmpcL" : "";
    return tags.find(tag) != std::string_view::npos;
}

bool is_well_formed(const protocol::Event& event) {
    const bool of_system = event.service == '#';
    if (of_system && event.tag == '?') return protocol::parse_board_info(event.body).has_value();
    if (of_system && event.tag == 'N') return protocol::parse_service_names(event.body).has_value();
    const std::string_view lists = of_system ? "SX" : event.service == 'I' ? "MmpcL" : "";
    return lists.find(event.tag) == std::string_view::npos || protocol::parse_body(event.body).has_value();
}

bool Request::is_question() const {
    return session::is_question(service(), tag());
}

}  // namespace asip::session
