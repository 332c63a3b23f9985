// SPDX-License-Identifier: Apache-2.0
// Imported before each test of a core: the page speaks English then.
import { readFileSync } from "node:fs";
import { speak } from "../../../gateway/page/core/language.js";

speak("en", JSON.parse(readFileSync(new URL("../../../gateway/page/languages/en.json", import.meta.url))));
