// SPDX-License-Identifier: Apache-2.0
// Writes lib/models.json, the standard service models without their examples, from services/: what npm does before it packs.
// In a clone lib/models.js reads services/ itself.
//
//     node generate_models.mjs [FILE]
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const { readStandard } = createRequire(import.meta.url)('./lib/models.js');
writeFileSync(process.argv[2] || new URL('lib/models.json', import.meta.url), `${JSON.stringify(readStandard(new URL('../services/', import.meta.url)))}\n`);
