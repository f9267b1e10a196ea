export class FeedList { take() {} }
