// SPDX-License-Identifier: GPL-3.0-or-later
/// Style sheets of libraries are imported as text; see build.mjs.
declare module "*.css" {
    const text: string;
    export default text;
}
