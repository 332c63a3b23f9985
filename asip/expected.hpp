#pragma once
#include <string>
#include <tl/expected.hpp>

namespace asip {

/// A value, or the reason there is none. The reason is text for a person unless a function documents another
/// type. An alias, so that it becomes std::expected the day every compiler we build and fuzz with has it.
template <class T, class E = std::string>
using Expected = tl::expected<T, E>;

template <class E>
using Unexpected = tl::unexpected<E>;

/// `return fail("no such pin: " + text);`
inline Unexpected<std::string> fail(std::string reason) {
    return Unexpected<std::string>(std::move(reason));
}

}  // namespace asip
