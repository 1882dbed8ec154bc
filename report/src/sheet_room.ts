// SPDX-License-Identifier: GPL-3.0-or-later
/// Chooses how much a page of a part shows, so that it fits on one sheet of paper.

import type { Sheet, SheetData } from "./data.ts";

/// The most that a page shows.
export interface Room {
    /// The size of the pictures: 0 is the largest.
    pictures: number;
    parts: number;
    labels: number;
    /// Doubts and warnings; also reasons; also notes of the run.
    notes: number;
    /// Files and versions; also conditions of the comparison.
    facts: number;
    /// Characters of a text.
    characters: number;
}

const [fewRows, fewestRows] = [8, 3];

/// From everything to what fits with the longest data. Every entry shows at most what the entry before shows.
export function roomsOf(data: SheetData, sheet: Sheet): Room[] {
    const parts = sheet.inspection?.rows.length ?? 0;
    const labels = sheet.inspection?.labels.length ?? 0;
    const facts = Math.max(sheet.facts.length, sheet.inspection?.facts.length ?? 0);
    const notes = Math.max(sheet.doubts.length + sheet.warnings.length, sheet.reasons.length, data.notes.length);
    const rooms: Room[] = [{ pictures: 0, parts, labels, notes, facts, characters: 4000 }];
    const atMost = (limits: Partial<Room>) => {
        const last = rooms.at(-1)!;
        const least = (key: keyof Room) => Math.min(last[key], limits[key] ?? Infinity);
        rooms.push({ pictures: limits.pictures ?? last.pictures, parts: least("parts"), labels: least("labels"), notes: least("notes"), facts: least("facts"), characters: least("characters") });
    };
    atMost({ pictures: 1 });
    atMost({ pictures: 2 });
    for (let rows = Math.max(parts, labels) - 1; rows >= fewRows; --rows) atMost({ parts: rows, labels: rows });
    atMost({ notes: 8, characters: 400 });
    atMost({ facts: 16 });
    atMost({ characters: 240 });
    atMost({ pictures: 3 });
    for (let rows = fewRows - 1; rows >= fewestRows; --rows) atMost({ parts: rows });
    for (let rows = fewRows - 1; rows >= fewestRows; --rows) atMost({ labels: rows });
    atMost({ notes: 4, facts: 10 });
    atMost({ facts: 6, characters: 120 });
    atMost({ notes: 2, facts: 4, characters: 80 });
    return rooms;
}

/// The first entry that fits, or the last one. Neighbouring parts need about the same, so the search begins at `guess`.
export function firstFit(count: number, fits: (index: number) => boolean, guess: number): number {
    let [low, high] = [0, count - 1];
    const start = Math.min(guess, high);
    if (fits(start)) high = start;
    else low = Math.min(start + 1, high);
    if (high === start && start > 0 && !fits(start - 1)) return start;
    while (low < high) {
        const middle = Math.floor((low + high) / 2);
        if (fits(middle)) high = middle;
        else low = middle + 1;
    }
    return low;
}

/// A text with at most about this number of characters, and how many are left out.
export function shortened(text: string, characters: number): string {
    const all = [...text];
    return all.length <= characters + 30 ? text : `${all.slice(0, characters).join("").trimEnd()} … (${all.length - characters} more characters)`;
}
