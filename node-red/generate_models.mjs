// SPDX-License-Identifier: Apache-2.0
// Writes lib/models.json, the standard service models without their examples, from services/: npm does it before it packs the module, or
// copies or links its folder. In a clone lib/models.js reads services/ itself.
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const { readStandard } = createRequire(import.meta.url)('./lib/models.js');
writeFileSync(new URL('lib/models.json', import.meta.url), `${JSON.stringify(readStandard(new URL('../services/', import.meta.url)))}\n`);
