"use strict";
// Shows the text around the word below each hit of the search.  Sphinx's own summary requests the page of the hit, which
// browsers refuse when the site is opened from a file; SEARCH_TEXTS (search_texts.js) holds the text of all pages.
(() => {
  const AROUND = 110;  // characters to either side of the word
  const asked = (new URLSearchParams(location.search).get("q") || "").toLowerCase().split(/[^\p{L}\p{N}_.-]+/u)
    .filter(Boolean);
  const stems = typeof Stemmer === "undefined" ? [] : asked.map((word) => new Stemmer().stemWord(word));

  // [start, end] of the first of the words in a text, whole words first, then their stems; null where none is there.
  function place(text) {
    for (const word of [...asked, ...stems]) {
      const plain = word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
      const found = new RegExp(`${plain}[\\p{L}\\p{N}_]*`, "iu").exec(text);
      if (found) return [found.index, found.index + found[0].length];
    }
    return null;
  }

  function context(text) {
    const [at, end] = place(text) || [0, 0];
    const first = at > AROUND ? text.indexOf(" ", at - AROUND) + 1 : 0;
    const last = end + AROUND < text.length ? text.lastIndexOf(" ", end + AROUND) : text.length;
    const line = Object.assign(document.createElement("p"), {className: "context"});
    line.append(first ? "… " : "", text.slice(first, at), Object.assign(document.createElement("mark"), {
      textContent: text.slice(at, end)}), text.slice(end, Math.max(last, end)), last < text.length ? " …" : "");
    return line;
  }

  function complete(list) {
    for (const link of list.querySelectorAll("li > a")) {
      const text = SEARCH_TEXTS[link.getAttribute("href").replace(/\.html.*/, "")];
      if (text && !link.parentElement.querySelector(".context")) link.parentElement.append(context(text));
    }
  }

  const list = document.getElementById("search-results");
  if (!list) return;
  new MutationObserver(() => complete(list)).observe(list, {childList: true, subtree: true});
  complete(list);
})();
