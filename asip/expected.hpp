// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <tl/expected.hpp>

namespace asip {

/// A value, or the reason why there is none. The reason is text for a person, one line without a full stop,
/// unless a function documents another type. No function of this library throws for bad input: exceptions are
/// left to errors of the program itself and to memory that has run out.
///
/// An alias, so that it becomes std::expected on the day when every compiler that builds and fuzzes this
/// project has it. Reading the value of one that has none is undefined; test it first.
template <class T, class E = std::string>
using Expected = tl::expected<T, E>;

template <class E>
using Unexpected = tl::unexpected<E>;

/// Makes the failed result: `return fail("no such pin: " + text);`
inline Unexpected<std::string> fail(std::string reason) {
    return Unexpected<std::string>(std::move(reason));
}

}  // namespace asip
