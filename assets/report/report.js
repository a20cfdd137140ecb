"use strict";
// The page is complete without this: it sorts and filters the frames, lays the baseline over the
// planes of now, and opens what a link or a printer asks for.
(() => {
  const all = (selector, inside = document) => [...inside.querySelectorAll(selector)];
  const by_id = (id) => document.getElementById(id);
  document.documentElement.classList.add("js");

  // ---- Frames: sorted by a column, filtered by their text ----
  const table = by_id("frames-table");
  const rows = table ? all("tbody tr", table) : [];
  const value_of = (row, column) => {
    const cell = row.cells[column];
    const text = cell?.dataset.value ?? "";
    return text === "" ? null : Number(text);
  };
  const sort = (header, direction) => {
    const column = header.cellIndex;
    const sign = direction === "ascending" ? 1 : -1;
    const order = rows.map((row, place) => ({ row, place, value: value_of(row, column) }));
    order.sort((a, b) => {
      if (a.value === null || b.value === null)
        return (a.value === null) - (b.value === null) || a.place - b.place;
      return sign * (a.value - b.value) || a.place - b.place;
    });
    for (const th of all("th[data-sort]", table)) th.setAttribute("aria-sort", "none");
    header.setAttribute("aria-sort", direction);
    table.tBodies[0].append(...order.map((entry) => entry.row));
  };
  for (const header of table ? all("th[data-sort]", table) : []) {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...header.childNodes);
    header.append(button);
    header.setAttribute("aria-sort", header.cellIndex === 0 ? "ascending" : "none");
    button.addEventListener("click", () => {
      const now = header.getAttribute("aria-sort");
      const first = header.dataset.sort || "ascending";
      const other = first === "ascending" ? "descending" : "ascending";
      sort(header, now === first ? other : first);
    });
  }

  const filter = by_id("filter");
  const apply_filter = () => {
    const words = by_id("filter-text").value.toLowerCase().split(/\s+/).filter(Boolean);
    const only_failing = by_id("filter-failing").checked;
    let shown = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      const fits = words.every((word) => text.includes(word)) &&
        (!only_failing || row.dataset.standing === "failed");
      row.hidden = !fits;
      const details = by_id(row.dataset.frame);
      if (details && details !== row) details.hidden = !fits;
      shown += fits;
    }
    by_id("filter-count").textContent =
      shown === rows.length ? `${shown} frames` : `${shown} of ${rows.length} frames`;
  };
  if (filter) {
    filter.hidden = false;
    filter.addEventListener("input", apply_filter);
    filter.addEventListener("submit", (event) => event.preventDefault());
  }

  // ---- Baseline and now, one over the other ----
  for (const compare of all(".compare")) {
    const range = compare.querySelector("input");
    const flip = compare.querySelector(".flip");
    const show = () => {
      compare.style.setProperty("--at", `${range.value}%`);
      range.setAttribute("aria-valuetext", `${range.value} % baseline`);
      flip.setAttribute("aria-pressed", String(range.value === "100"));
    };
    range.addEventListener("input", show);
    flip.addEventListener("click", () => {
      range.value = range.value === "100" ? "0" : "100";
      show();
    });
    compare.querySelector(".tools").hidden = false;
    show();
  }

  // ---- Text to copy ----
  for (const text of all(".copy")) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "copy-button";
    button.textContent = "Copy";
    button.setAttribute("aria-label", `Copy: ${text.textContent}`);
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(text.textContent);
        button.textContent = "Copied";
        setTimeout(() => (button.textContent = "Copy"), 1500);
      } catch {
        getSelection().selectAllChildren(text);
      }
    });
    text.after(button);
  }

  // ---- Pictures that lie beside the page, where they do ----
  const beside = document.querySelector("main").dataset.beside;
  if (beside) {
    const probe = new Image();
    probe.addEventListener("error", () => {
      document.documentElement.classList.add("alone");
      by_id("alone").hidden = false;
    });
    probe.src = beside;
  }
  for (const details of all("details.frame"))
    details.addEventListener("toggle", () => {
      if (!details.open) return;
      for (const link of all("a[data-copy]", details)) {
        const image = new Image();
        image.alt = "";
        image.addEventListener("load", () => link.prepend(image));
        image.src = link.dataset.copy;
        link.removeAttribute("data-copy");
      }
    });

  // ---- What is linked or printed is unfolded ----
  const reveal = () => {
    const target = by_id(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    const folded = [];
    for (let at = target; at; at = at.parentElement?.closest("details"))
      if (at.localName === "details" && (at.hidden || !at.open)) folded.push(at);
    for (const details of folded) {
      details.hidden = false;
      details.open = true;
    }
    if (folded.length > 0) target.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  reveal();
  addEventListener("keydown", (event) => {
    const close = document.querySelector("figure:target .close");
    if (event.key === "Escape" && close) close.click();
  });
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = all("details:not([open])");
    for (const details of closed) details.open = true;
  });
  addEventListener("afterprint", () => {
    for (const details of closed) details.open = false;
  });
})();
