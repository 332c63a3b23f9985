#include "asip/session/request.hpp"

#include <string_view>

namespace asip::session {

bool is_question(char service, char tag) {
    const std::string_view tags = service == '#' ? "?NSXIE" : service == 'I' ? "Mmpc" : "";
    return tags.find(tag) != std::string_view::npos;
}

bool Request::is_question() const {
    return session::is_question(service(), tag());
}

}  // namespace asip::session
